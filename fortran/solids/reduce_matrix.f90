!> The stiffness of the free equations from the stiffness of all physical dofs: T^T K T.
module lopin_reduce_matrix
   use lopin_kinds, only : wp, ik
   use lopin_csc, only : csc_type, storage
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

      if (constraints%plain) then
         call filter(k, constraints, number, n, reduced)
      else
         call transform(k, constraints, number, n, reduced)
      end if
   end subroutine reduce_matrix

   !> Keep rows and columns; the order of dofs is that of the equations, so columns stay sorted.
   subroutine filter(k, constraints, number, n, reduced)
      type(csc_type), intent(in) :: k
      type(constraints_type), intent(in) :: constraints
      integer, intent(in) :: number(:), n
      type(csc_type), intent(out) :: reduced
      integer, allocatable :: of_dof(:)
      integer :: i, j, column, entry, kept

      allocate (of_dof(constraints%ndof), source=0)
      do i = 1, constraints%ndof
         if (constraints%first(i + 1) == constraints%first(i)) cycle
         of_dof(i) = number(constraints%equation(constraints%first(i)))
      end do
      reduced%n = n
      reduced%kind = storage%symmetric_lower
      allocate (reduced%colptr(n + 1), reduced%row(size(k%row)), reduced%value(size(k%row)))
      reduced%colptr(1) = 0_ik
      kept = 0
      column = 0
      do j = 1, k%n
         if (of_dof(j) == 0) cycle
         column = column + 1
         do entry = k%colptr(j) + 1, k%colptr(j + 1)
            i = of_dof(k%row(entry) + 1)
            if (i == 0) cycle
            kept = kept + 1
            reduced%row(kept) = int(i - 1, ik)
            reduced%value(kept) = k%value(entry)
         end do
         reduced%colptr(column + 1) = int(kept, ik)
      end do
      reduced%row = reduced%row(:kept)
      reduced%value = reduced%value(:kept)
   end subroutine filter

   !> Every entry meets the terms of its row and of its column.
   subroutine transform(k, constraints, number, n, reduced)
      type(csc_type), intent(in) :: k
      type(constraints_type), intent(in) :: constraints
      integer, intent(in) :: number(:), n
      type(csc_type), intent(out) :: reduced
      integer, allocatable :: row(:), column(:)
      real(wp), allocatable :: value(:)
      integer :: i, j, entry, total, pass

      do pass = 1, 2
         total = 0
         do j = 1, k%n
            do entry = k%colptr(j) + 1, k%colptr(j + 1)
               i = k%row(entry) + 1
               call spread_entry(i, j, k%value(entry))
            end do
         end do
         if (pass == 1) allocate (row(total), column(total), value(total))
      end do
      call reduced%new_from_triplets(n, storage%symmetric_lower, row, column, value)

   contains

      !> K_ij times every pair of terms of the dofs i and j.
      subroutine spread_entry(i, j, stiffness)
         integer, intent(in) :: i, j
         real(wp), intent(in) :: stiffness
         real(wp) :: factor
         integer :: a, b

         do a = constraints%first(i), constraints%first(i + 1) - 1
            if (number(constraints%equation(a)) == 0) cycle
            do b = constraints%first(j), constraints%first(j + 1) - 1
               if (number(constraints%equation(b)) == 0) cycle
               total = total + 1
               if (pass == 1) cycle
               factor = 1.0_wp
               ! An entry off the diagonal stands for its mirror too: both fall on one place.
               if (i /= j .and. constraints%equation(a) == constraints%equation(b)) factor = 2.0_wp
               row(total) = number(constraints%equation(a))
               column(total) = number(constraints%equation(b))
               if (i == j .and. row(total) < column(total)) factor = 0.0_wp
               value(total) = factor*constraints%coefficient(a)*constraints%coefficient(b)*stiffness
            end do
         end do
      end subroutine spread_entry
   end subroutine transform
end module lopin_reduce_matrix
