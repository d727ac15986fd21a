!> How far the nodes of each element move apart: checks of small displacements and of corners ask it
!> of all elements in every increment.
module lopin_node_spread
   use lopin_kinds, only : wp
   use lopin_model, only : model_type
   use lopin_dofs, only : dofs_type
   implicit none
   private
   public :: node_spread_type

   !> The dofs of the nodes of the elements, one element after the other.
   type :: node_spread_type
      private
      integer :: ndim = 0
      integer, allocatable :: first(:)         !! (nelement+1) its first in `dof`
      integer, allocatable :: dof(:)           !! (ndim by nodes)
   contains
      procedure :: new
      procedure :: squares
   end type node_spread_type

contains

   !> Of all elements with a section: each node of theirs has all translations.
   subroutine new(self, model, dofs)
      class(node_spread_type), intent(out) :: self
      type(model_type), intent(in) :: model
      type(dofs_type), intent(in) :: dofs
      integer :: e, k, at

      self%ndim = model%mesh%ndim
      allocate (self%first(model%mesh%nelement + 1), self%dof(self%ndim*size(model%mesh%conn)))
      at = 0
      do e = 1, model%mesh%nelement
         self%first(e) = at + 1
         if (model%mesh%section(e) == 0) cycle
         do k = 1, size(model%mesh%conn, 1)
            if (model%mesh%conn(k, e) == 0) exit
            self%dof(at + 1:at + self%ndim) = dofs%id(:self%ndim, model%mesh%conn(k, e))
            at = at + self%ndim
         end do
      end do
      self%first(model%mesh%nelement + 1) = at + 1
      self%dof = self%dof(:at)
   end subroutine new

   !> Sum over the nodes of each element of the squares of their ways beside that of the first one.
   pure subroutine squares(self, u, square)
      class(node_spread_type), intent(in) :: self
      real(wp), intent(in) :: u(:)             !! (ndof) [length]
      real(wp), intent(out) :: square(:)       !! (nelement) 0 without a section [length^2]

      if (self%ndim == 2) then
         call in_plane(size(square), self%first, self%dof, u, square)
      else
         call in_space(size(square), self%first, self%dof, u, square)
      end if
   end subroutine squares

   pure subroutine in_plane(n, first, dof, u, square)
      integer, intent(in) :: n, first(n + 1), dof(*)
      real(wp), intent(in) :: u(:)
      real(wp), intent(out) :: square(n)
      real(wp) :: x, y, sum_
      integer :: e, k

      do e = 1, n
         sum_ = 0.0_wp
         if (first(e + 1) > first(e)) then
            x = u(dof(first(e)))
            y = u(dof(first(e) + 1))
            do k = first(e) + 2, first(e + 1) - 1, 2
               sum_ = sum_ + (u(dof(k)) - x)**2 + (u(dof(k + 1)) - y)**2
            end do
         end if
         square(e) = sum_
      end do
   end subroutine in_plane

   pure subroutine in_space(n, first, dof, u, square)
      integer, intent(in) :: n, first(n + 1), dof(*)
      real(wp), intent(in) :: u(:)
      real(wp), intent(out) :: square(n)
      real(wp) :: x, y, z, sum_
      integer :: e, k

      do e = 1, n
         sum_ = 0.0_wp
         if (first(e + 1) > first(e)) then
            x = u(dof(first(e)))
            y = u(dof(first(e) + 1))
            z = u(dof(first(e) + 2))
            do k = first(e) + 3, first(e + 1) - 1, 3
               sum_ = sum_ + (u(dof(k)) - x)**2 + (u(dof(k + 1)) - y)**2 + (u(dof(k + 2)) - z)**2
            end do
         end if
         square(e) = sum_
      end do
   end subroutine in_space
end module lopin_node_spread
