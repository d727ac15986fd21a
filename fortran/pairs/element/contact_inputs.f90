!> The inputs of a contact point: dofs that its forces and its row depend on.
module lopin_contact_inputs
   use lopin_smooth_facet, only : most_stencil
   use lopin_model, only : model_type
   use lopin_dofs, only : dofs_type
   use lopin_facet_basis, only : facet_basis_type
   use lopin_nonlinear_points, only : nonlinear_points_type
   use lopin_closest_feature, only : opposite_type, anchor_type
   use lopin_master_surfaces, only : masters_type
   implicit none
   private
   public :: point_view_type, inputs_type, list_inputs

   integer, parameter :: most_dofs = 3*(most_stencil + 8) + 18

   !> One contact point with what lies opposite it, in the scene that it belongs to.
   type :: point_view_type
      integer :: i = 0                         !! its number in `points`
      type(model_type), pointer :: model => null()
      type(dofs_type), pointer :: dofs => null()
      type(facet_basis_type), pointer :: basis => null()
      type(masters_type), pointer :: masters => null()
      class(nonlinear_points_type), pointer :: points => null()
      type(opposite_type), pointer :: opposite => null()
      type(anchor_type), pointer :: anchor => null()
   end type point_view_type

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
   subroutine list_inputs(self, point, first_row)
      type(inputs_type), intent(out) :: self
      type(point_view_type), intent(in) :: point
      integer, intent(in) :: first_row         !! of the multiplier; 0: none
      integer :: k, m, d, body, node

      d = point%model%mesh%ndim
      associate (opposite => point%opposite, anchor => point%anchor)
         m = 0
         if (allocated(opposite%inner)) m = size(opposite%inner%node)
         allocate (self%dof(most_dofs + 3*m))
         call take_node(point%points%node(point%i), self%slave)
         do m = 1, opposite%nnode
            call take_node(opposite%node(m), self%master(:, m))
         end do
         do m = 1, anchor%nnode
            call take_node(anchor%node(m), self%anchor(:, m))
         end do
         if (allocated(opposite%sample)) then
            do m = 1, 2
               call take_node(opposite%sample(m)%node, self%sample(:, m))
            end do
         end if
         if (allocated(opposite%inner)) call take_around(opposite%inner%node)
      end associate
      body = point%masters%of(point%points%pair(point%i))%body
      if (body > 0) then
         node = point%model%rigid_body(body)%reference
         call take_node(node, self%reference)
         do k = 4, 6
            call take(point%dofs%id(k, node), self%rotation(k - 3))
         end do
      end if
      self%nu = self%n
      if (first_row == 0) return
      do k = 1, d
         call take(point%dofs%n + first_row + k - 1, self%multiplier(k))
      end do

   contains

      !> Nodes of the facets that have points inside; the first is the slave.
      subroutine take_around(around)
         integer, intent(in) :: around(:)
         integer :: j

         allocate (self%near(3, size(around)), source=0)
         self%near(:, 1) = self%slave
         do j = 2, size(around)
            call take_node(around(j), self%near(:, j))
         end do
      end subroutine take_around

      subroutine take_node(of, input)
         integer, intent(in) :: of             !! node
         integer, intent(inout) :: input(3)
         integer :: j

         do j = 1, d
            call take(point%dofs%id(j, of), input(j))
         end do
      end subroutine take_node

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
