!> The inputs of a contact point: dofs that its forces and its row depend on.
module lopin_contact_inputs
   use lopin_smooth_facet, only : most_stencil
   use lopin_model, only : model_type
   use lopin_dofs, only : dofs_type
   use lopin_nonlinear_points, only : nonlinear_points_type
   use lopin_closest_feature, only : opposite_type, anchor_type
   use lopin_master_surfaces, only : masters_type
   implicit none
   private
   public :: inputs_type, list_inputs

   integer, parameter :: most_dofs = 3*(most_stencil + 8) + 18

   !> The inputs of a point in the order of its local dofs.
   type :: inputs_type
      integer :: n = 0, nu = 0
      integer, allocatable :: dof(:)
      integer :: slave(3) = 0                  !! input of each component; 0: it is held
      integer :: master(3, most_stencil) = 0, anchor(3, 8) = 0
      integer :: sample(3, 2) = 0
      integer, allocatable :: near(:, :)       !! (3, nodes) of the nodes of points inside facets
      integer :: reference(3) = 0, rotation(3) = 0, multiplier(3) = 0
      integer :: growth = 0                    !! behind the others: of the point's area
   end type inputs_type

contains

   !> The dofs of a point: slave, master nodes, anchor nodes or tool, then multipliers.
   subroutine list_inputs(self, model, dofs, masters, points, i, opposite, anchor, first_row)
      type(inputs_type), intent(out) :: self
      type(model_type), intent(in) :: model
      type(dofs_type), intent(in) :: dofs
      type(masters_type), intent(in) :: masters
      type(nonlinear_points_type), intent(in) :: points
      integer, intent(in) :: i
      type(opposite_type), intent(in) :: opposite
      type(anchor_type), intent(in) :: anchor
      integer, intent(in) :: first_row
      integer :: k, m, d

      d = model%mesh%ndim
      m = 0
      if (allocated(opposite%inner)) m = size(opposite%inner%node)
      allocate (self%dof(most_dofs + 3*m))
      do k = 1, d
         call take(dofs%id(k, points%node(i)), self%slave(k))
      end do
      do m = 1, opposite%nnode
         do k = 1, d
            call take(dofs%id(k, opposite%node(m)), self%master(k, m))
         end do
      end do
      do m = 1, anchor%nnode
         do k = 1, d
            call take(dofs%id(k, anchor%node(m)), self%anchor(k, m))
         end do
      end do
      if (allocated(opposite%sample)) then
         do m = 1, 2
            do k = 1, d
               call take(dofs%id(k, opposite%sample(m)%node), self%sample(k, m))
            end do
         end do
      end if
      if (allocated(opposite%inner)) call list_around
      if (masters%of(points%pair(i))%body > 0) then
         associate (node => model%rigid_body(masters%of(points%pair(i))%body)%reference)
            do k = 1, d
               call take(dofs%id(k, node), self%reference(k))
            end do
            do k = 4, 6
               call take(dofs%id(k, node), self%rotation(k - 3))
            end do
         end associate
      end if
      self%nu = self%n
      if (first_row == 0) return
      do k = 1, d
         call take(dofs%n + first_row + k - 1, self%multiplier(k))
      end do

   contains

      !> Nodes of the facets that have points inside.
      subroutine list_around
         integer :: j

         associate (node => opposite%inner%node)
            allocate (self%near(3, size(node)), source=0)
            self%near(:, 1) = self%slave
            do j = 2, size(node)
               do k = 1, d
                  call take(dofs%id(k, node(j)), self%near(k, j))
               end do
            end do
         end associate
      end subroutine list_around

      subroutine take(dof, input)
         integer, intent(in) :: dof
         integer, intent(inout) :: input
         if (dof == 0) return
         self%n = self%n + 1
         self%dof(self%n) = dof
         input = self%n
      end subroutine take
   end subroutine list_inputs
end module lopin_contact_inputs
