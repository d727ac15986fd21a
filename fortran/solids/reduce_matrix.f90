!> The stiffness of the free equations from the stiffness of all physical dofs: T^T K T.
module lopin_reduce_matrix
   use lopin_kinds, only : wp, ik
   use lopin_csc, only : csc_type, storage
   use lopin_csc_sum, only : sum_of
   use lopin_spread_matrix, only : spread_matrix
   use lopin_constraints, only : constraints_type
   implicit none
   private
   public :: reduce_matrix

contains

   !> Where every dof is one equation or prescribed (`plain`), columns are only filtered.
   subroutine reduce_matrix(k, constraints, number, n, reduced)
      type(csc_type), intent(in) :: k                         !! (ndof) lower triangle
      type(constraints_type), intent(in) :: constraints
      integer, intent(in) :: number(:)   !! (neq) row of the reduced matrix; 0: left out
      integer, intent(in) :: n                                !! rows of the reduced matrix
      type(csc_type), intent(out) :: reduced
      integer, allocatable :: of_dof(:)

      if (constraints%plain) then
         call number_dofs(constraints, number, of_dof)
         call keep(k, of_dof, n, reduced)
      else
         call transform(k, constraints, number, n, reduced)
      end if
   end subroutine reduce_matrix

   !> Dofs that are one equation as it is, or prescribed.
   subroutine find_plain(constraints, plain)
      type(constraints_type), intent(in) :: constraints
      logical, allocatable, intent(out) :: plain(:)
      integer :: i

      allocate (plain(constraints%ndof), source=.false.)
      do i = 1, constraints%ndof
         associate (first => constraints%first(i), n => constraints%first(i + 1) &
            & - constraints%first(i))
            plain(i) = n == 0
            if (n == 1) plain(i) = constraints%dof_of_equation(constraints%equation(first)) == i &
               & .and. .not. abs(constraints%coefficient(first) - 1.0_wp) > 0.0_wp
         end associate
      end do
   end subroutine find_plain

   !> The row of each dof in the reduced matrix, by its first equation; 0: none.
   subroutine number_dofs(constraints, number, of_dof)
      type(constraints_type), intent(in) :: constraints
      integer, intent(in) :: number(:)
      integer, allocatable, intent(out) :: of_dof(:)
      integer :: i

      allocate (of_dof(constraints%ndof), source=0)
      do i = 1, constraints%ndof
         if (constraints%first(i + 1) == constraints%first(i)) cycle
         of_dof(i) = number(constraints%equation(constraints%first(i)))
      end do
   end subroutine number_dofs

   !> Keep rows and columns; the order of dofs is that of the equations, so columns stay sorted.
   subroutine keep(k, of_dof, n, reduced)
      type(csc_type), intent(in) :: k
      integer, intent(in) :: of_dof(:), n
      type(csc_type), intent(out) :: reduced
      integer :: i, j, column, entry, kept

      reduced%n = n
      reduced%kind = storage%symmetric_lower
      allocate (reduced%colptr(n + 1), reduced%row(size(k%row)), reduced%value(size(k%row)))
      reduced%colptr(1) = 0_ik
      kept = 0
      column = 0
      do j = 1, k%n
         if (of_dof(j) == 0) cycle
         ! Equations that no dof here has are empty columns.
         reduced%colptr(column + 2:of_dof(j)) = int(kept, ik)
         column = of_dof(j)
         do entry = k%colptr(j) + 1, k%colptr(j + 1)
            i = of_dof(k%row(entry) + 1)
            if (i == 0) cycle
            kept = kept + 1
            reduced%row(kept) = int(i - 1, ik)
            reduced%value(kept) = k%value(entry)
         end do
         reduced%colptr(column + 1) = int(kept, ik)
      end do
      reduced%colptr(column + 2:) = int(kept, ik)
      reduced%row = reduced%row(:kept)
      reduced%value = reduced%value(:kept)
   end subroutine keep

   !> Entries between dofs that are equations of their own are kept as they are; the others meet the
   !> terms of their row and of their column.
   subroutine transform(k, constraints, number, n, reduced)
      type(csc_type), intent(in) :: k
      type(constraints_type), intent(in) :: constraints
      integer, intent(in) :: number(:), n
      type(csc_type), intent(out) :: reduced
      type(csc_type) :: kept, spread
      integer, allocatable :: of_dof(:)
      logical, allocatable :: plain(:)

      call find_plain(constraints, plain)
      call number_dofs(constraints, number, of_dof)
      where (.not. plain) of_dof = 0
      call keep(k, of_dof, n, kept)
      call spread_matrix(k, constraints, number, n, plain, spread)
      call sum_of(kept, spread, reduced)
      call complete_diagonal(reduced)
   end subroutine transform

   !> Every diagonal entry is present.
   subroutine complete_diagonal(a)
      type(csc_type), intent(inout) :: a
      type(csc_type) :: diagonal, sum
      integer :: j
      logical :: missing

      missing = .false.
      do j = 1, a%n
         if (a%colptr(j + 1) == a%colptr(j)) then
            missing = .true.
         else
            missing = missing .or. a%row(a%colptr(j) + 1) /= j - 1
         end if
      end do
      if (.not. missing) return
      diagonal%n = a%n
      diagonal%kind = a%kind
      diagonal%colptr = [(int(j, ik), j=0, a%n)]
      diagonal%row = [(int(j, ik), j=0, a%n - 1)]
      allocate (diagonal%value(a%n), source=0.0_wp)
      call sum_of(a, diagonal, sum)
      a = sum
   end subroutine complete_diagonal
end module lopin_reduce_matrix
