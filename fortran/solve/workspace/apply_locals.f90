!> Products of the exact matrices of contact points with physical displacements.
module lopin_apply_locals
   use lopin_kinds, only : wp
   use lopin_local_matrix, only : local_matrix_type, turned_force
   implicit none
   private
   public :: apply_locals

contains

   !> What the local matrices make of displacements (and no multipliers), on dofs and rows.
   subroutine apply_locals(nlocal, local, u, force)
      integer, intent(in) :: nlocal
      type(local_matrix_type), intent(in) :: local(:)
      real(wp), intent(in) :: u(:)               !! (ndof)
      real(wp), intent(inout) :: force(:)        !! (ndof + nmultiplier) added to
      integer :: i, j, m

      do i = 1, nlocal
         associate (l => local(i))
            if (allocated(l%glue)) then
               call apply_glue(l, u, force)
               cycle
            end if
            ! A node of the facet may be one of the anchor too: its dof stands twice.
            do j = 1, size(l%dof)
               force(l%dof(j)) = force(l%dof(j)) + dot_product(l%k(j, :l%nu), u(l%dof(:l%nu)))
            end do
            if (allocated(l%by_bound)) then
               do j = 1, size(l%by_bound)
                  force(l%dof(j)) = force(l%dof(j)) + l%by_bound(j)*dot_product(l%read_slope, &
                     & u(l%read_dof))
               end do
            end if
            do j = l%nu + 1, size(l%dof)
               if (l%dof(j) > size(u)) cycle
               do m = 1, l%nu
                  force(l%dof(m)) = force(l%dof(m)) + l%k(m, j)*u(l%dof(j))
               end do
            end do
         end associate
      end do
   end subroutine apply_locals

   pure subroutine apply_glue(local, u, force)
      type(local_matrix_type), intent(in) :: local
      real(wp), intent(in) :: u(:)               !! (ndof)
      real(wp), intent(inout) :: force(:)        !! (ndof + nmultiplier) added to
      real(wp) :: s(size(local%reach, 1))

      associate (at => local%dof(:local%nu), row => local%dof(local%nu + 1:), g => local%glue)
         s = matmul(local%reach, u(at))
         force(row) = force(row) + s
         force(at) = force(at) + g%weight*g%c*matmul(s, local%reach)
         if (g%turns) force(at) = force(at) + turned_force(g, local%tangent, u(at))
      end associate
   end subroutine apply_glue
end module lopin_apply_locals
