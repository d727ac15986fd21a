!> The contact element: traction of a row, and its forces and slopes in the local matrix, wherever
!> its weights, gap, normal and slip come from.
!>
!> Nodes opposite tools and facets (lopin_contact_element) and mortar rows in the plane
!> (lopin_mortar_element) measure a row in dual numbers, one block of columns of its derivatives
!> after the other:
!>
!>    call begin_row(row, local, columns, with_tangent)
!>    do
!>       row%gap, normal, slip, multiplier = ...  with slopes along columns row%from + 1 and on
!>       call press_row(row, law)
!>       force = what row%z does to the dofs
!>       if (last_block(row, local, force)) exit
!>    end do
!>    call end_row(state, local, row, enforcement, force)
module lopin_row_element
   use lopin_kinds, only : wp
   use lopin_dual, only : dual_type, dual_width, constant, operator(+), operator(-), &
      & operator(*), operator(/), assignment(=)
   use lopin_local_matrix, only : local_matrix_type
   use lopin_contact_row, only : enforcement_parameters_type, point_law_type, row_type, &
      & point_state_type, contact_status
   use lopin_contact_traction, only : traction_of, normal_stiffness
   implicit none
   private
   public :: begin_row, press_row, last_block, end_row, set_spring

   !> Shares of a traction below which it is none.
   real(wp), parameter :: least = 1.0e-6_wp

contains

   !> Room for the matrix; without a tangent the one block has no columns.
   pure subroutine begin_row(row, local, columns, with_tangent)
      type(row_type), intent(inout) :: row
      type(local_matrix_type), intent(inout) :: local   !! its dofs are listed
      integer, intent(in) :: columns
      logical, intent(in) :: with_tangent

      row%columns = columns
      row%with_tangent = with_tangent
      row%from = merge(0, columns, with_tangent)
      row%slip = constant(0.0_wp)
      if (.not. with_tangent) return
      if (allocated(local%k)) deallocate (local%k)
      allocate (local%k(size(local%dof), columns), source=0.0_wp)
      allocate (row%along_gap(local%nu), row%along_slip(row%ndim, local%nu))
   end subroutine begin_row

   !> Traction and residual by the law, or of what is glued.
   pure subroutine press_row(row, law, growth)
      type(row_type), intent(inout) :: row
      type(point_law_type), intent(in) :: law
      type(dual_type), intent(in), optional :: growth   !! at%growth with its slopes; else it stands
      integer :: d, k

      d = row%ndim
      row%z = constant(0.0_wp)
      row%residual = constant(0.0_wp)
      if (.not. law%enforcement%tied) then
         call traction_of(row, law, growth)
         return
      end if
      associate (n => row%normal(:d), z => row%z(:d), enforcement => law%enforcement)
         ! Glued: all directions, from where the point was at the start.
         z = row%multiplier(:d) - enforcement%c*(row%arm(:d) - row%held_gap*n)
         if (enforcement%partly) z = held_part(enforcement%held(:d, :d), z)
         row%residual(:d) = (row%multiplier(:d) - z)/enforcement%c
      end associate
      row%status = contact_status%stick
      row%shear = 0.0_wp
      do k = 1, d
         row%shear(k, k) = law%enforcement%c
      end do
   end subroutine press_row

   !> What is left of a traction in the directions in which a tie holds.
   pure function held_part(projector, z) result(part)
      real(wp), intent(in) :: projector(:, :)
      type(dual_type), intent(in) :: z(:)
      type(dual_type) :: part(size(z))
      integer :: k

      part = 0.0_wp
      do k = 1, size(z)
         part = part + projector(:, k)*z(k)
      end do
   end function held_part

   !> Put the columns of the block into the matrix; .false.: there are more.
   logical function last_block(row, local, force) result(last)
      type(row_type), intent(inout) :: row
      type(local_matrix_type), intent(inout) :: local
      type(dual_type), intent(in) :: force(:)  !! (nu) on the dofs [force]
      integer :: k, width

      last = .true.
      if (.not. row%with_tangent) return
      ! What is open and has no multiplier pushes nothing, wherever it goes.
      if (row%status == contact_status%open .and. .not. row%has_rows) return
      associate (from => row%from, nu => local%nu)
         width = min(dual_width, row%columns - from)
         do k = 1, nu
            local%k(k, from + 1:from + width) = -force(k)%d(:width)
         end do
         do k = nu + 1, size(local%dof)
            local%k(k, from + 1:from + width) = row%residual(k - nu)%d(:width)
         end do
         do k = from + 1, min(from + width, nu)
            row%along_gap(k) = row%gap%d(k - from)
            row%along_slip(:, k) = row%slip(:row%ndim)%d(k - from)
         end do
         from = from + dual_width
         last = from >= row%columns
      end associate
   end function last_block

   !> Values of the last block, and the spring of the row.
   subroutine end_row(state, local, row, enforcement, force)
      type(point_state_type), intent(inout) :: state
      type(local_matrix_type), intent(inout) :: local
      type(row_type), intent(in) :: row
      type(enforcement_parameters_type), intent(in) :: enforcement
      type(dual_type), intent(in) :: force(:)

      state%status = row%status
      state%force = force%v
      state%row = row%residual%v
      state%gap = row%gap%v
      state%slip = row%slip%v
      if (row%with_tangent) call set_spring(local, enforcement, row, row%along_gap, row%along_slip)
   end subroutine end_row

   !> w (c g' g'^T + s'^T shear s') for a closed row, and its multiplier rows as if normals stood
   !> still.
   pure subroutine set_spring(local, enforcement, row, along_gap, along_slip)
      type(local_matrix_type), intent(inout) :: local
      type(enforcement_parameters_type), intent(in) :: enforcement
      type(row_type), intent(in) :: row
      real(wp), intent(in) :: along_gap(:)     !! (nu) slopes of the gap
      real(wp), intent(in) :: along_slip(:, :) !! (ndim, nu) of the slip
      real(wp) :: press
      integer :: j, nu

      nu = size(along_gap)
      if (allocated(local%spring)) deallocate (local%spring)
      if (allocated(local%flat_row)) deallocate (local%flat_row)
      if (allocated(local%reach)) deallocate (local%reach)
      if (allocated(local%glue)) deallocate (local%glue)
      allocate (local%spring(nu, nu), source=0.0_wp)
      if (row%has_rows) allocate (local%flat_row(row%ndim, nu), source=0.0_wp)
      if (row%status == contact_status%open) return
      press = normal_stiffness(enforcement, row%gap%v + row%shift)
      associate (shear => row%shear(:row%ndim, :row%ndim), normal => row%normal(:row%ndim)%v)
         do j = 1, nu
            local%spring(:, j) = row%weight*(press*along_gap*along_gap(j) &
               & + matmul(transpose(along_slip), matmul(shear, along_slip(:, j))))
            if (row%has_rows) local%flat_row(:, j) = normal*along_gap(j) &
               & + matmul(shear, along_slip(:, j))/enforcement%c
         end do
         if (size(local%dof) >= nu + row%ndim) call set_reach(local, row, enforcement%c, press, &
            & along_gap, along_slip)
      end associate
   end subroutine set_spring

   !> How far the point goes, and with which stiffness its springs and its unknown traction meet it:
   !> z = Z (l - c g) gives Z c without the coupling of pressure into friction, and Z Z c. Nothing
   !> where the traction gives way more than it presses.
   pure subroutine set_reach(local, row, c, press, along_gap, along_slip)
      type(local_matrix_type), intent(inout) :: local
      type(row_type), intent(in) :: row
      real(wp), intent(in) :: c                !! [stress/length]
      real(wp), intent(in) :: press            !! of the springs along the normal [stress/length]
      real(wp), intent(in) :: along_gap(:)     !! (nu)
      real(wp), intent(in) :: along_slip(:, :) !! (ndim, nu)
      real(wp) :: z(row%ndim, row%ndim), share
      integer :: i, j, d, nu

      d = row%ndim
      nu = size(along_gap)
      associate (n => row%normal(:d)%v, shear => row%shear(:d, :d))
         do j = 1, d
            do i = 1, d
               z(i, j) = -0.5_wp*c*(local%k(nu + i, nu + j) + local%k(nu + j, nu + i))
            end do
            z(j, j) = z(j, j) + 1.0_wp
         end do
         share = dot_product(n, matmul(z, n))
         if (share < 0.0_wp .or. sum([(z(i, i), i=1, d)]) - share < -least) return
         local%stiff = shear
         local%firm = matmul(shear, z)
         local%firm = 0.5_wp*(local%firm + transpose(local%firm))
         call turn_to_normal(local%stiff, n, press)
         call turn_to_normal(local%firm, n, press*share)
         local%stiff = row%weight*local%stiff
         local%firm = row%weight*local%firm
         allocate (local%reach(d, nu))
         do j = 1, nu
            local%reach(:, j) = along_slip(:, j) + n*(along_gap(j) &
               & - dot_product(n, along_slip(:, j)))
         end do
      end associate
   end subroutine set_reach

   !> a <- (1 - n n^T) a (1 - n n^T) + s n n^T.
   pure subroutine turn_to_normal(a, n, s)
      real(wp), intent(inout) :: a(:, :)       !! symmetric
      real(wp), intent(in) :: n(:), s
      real(wp) :: an(size(n))
      integer :: j

      an = matmul(a, n)
      an = an - 0.5_wp*(dot_product(n, an) + s)*n
      do j = 1, size(n)
         a(:, j) = a(:, j) - an*n(j) - n*an(j)
      end do
   end subroutine turn_to_normal
end module lopin_row_element
